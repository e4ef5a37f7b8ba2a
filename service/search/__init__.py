"""The compiled local search, which improves the whole front of an instance.

`improve` is the entrance. `schedule` decides what is searched next, `local_search` and
`pareto_local_search` search, `moves` change a `working_tour`, `candidates` and `costs` say where
and at what price, and the `archive` collects what is nondominated. `bound` proves how much
better any front could be.
"""
