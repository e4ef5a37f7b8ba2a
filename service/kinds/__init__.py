"""The kinds of plans, a folder and a row of the table `KINDS` each; and fronts as JSON."""
