"""Read the cells of tables: numbers with their signs, ids, totals, times, dates and durations."""
