"""The kinds of plans: a row of the table `KINDS` and a folder each; and fronts as JSON."""
