"""The kinds of plans: a row of the table `KINDS` each; how each is planned; and fronts as JSON."""
