"""Say in which slots an order can be promised, and what each costs the plan that is driven."""
