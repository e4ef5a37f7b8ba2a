"""The best known plans of benchmarks with time windows: the number of vehicles and the distance.

They have the fewest vehicles, and the least distance with these, under exact distances: those that
SINTEF's Transportation Optimization Portal lists (sintef.no/projectweb/top), as others quote its
tables in 2026. Names are in capitals.
"""

from typing import NamedTuple


class Known(NamedTuple):
    """The fewest vehicles, and the least distance with these."""

    vehicles: int
    distance: float


def known_plan(name: str) -> Known | None:
    """Return the best known plan of an instance, None if it is not in the tables."""
    return _KNOWN.get(name)


def names_of(table: str) -> list[str]:
    """Return the names of the instances in a table."""
    return list(_read(table))


def _read(table: str) -> dict[str, Known]:
    """Read rows of a class, and for each of its instances its number, vehicles and distance."""
    read = {}
    for row in table.strip().splitlines():
        kind, *cells = row.split()
        for cell in cells:
            number, vehicles, distance = cell.split("/")
            read[f"{kind}{number}"] = Known(int(vehicles), float(distance))
    return read


SOLOMON = """
C 101/10/828.94 102/10/828.94 103/10/828.06 104/10/824.78 105/10/828.94 106/10/828.94
C 107/10/828.94 108/10/828.94 109/10/828.94
C 201/3/591.56 202/3/591.56 203/3/591.17 204/3/590.60 205/3/588.88 206/3/588.49
C 207/3/588.29 208/3/588.32
R 101/19/1650.80 102/17/1486.12 103/13/1292.68 104/9/1007.31 105/14/1377.11 106/12/1252.03
R 107/10/1104.66 108/9/960.88 109/11/1194.73 110/10/1118.84 111/10/1096.72 112/9/982.14
R 201/4/1252.37 202/3/1191.70 203/3/939.50 204/2/825.52 205/3/994.42 206/3/906.14
R 207/2/890.61 208/2/726.82 209/3/909.16 210/3/939.37 211/2/885.71
RC 101/14/1696.95 102/12/1554.75 103/11/1261.67 104/10/1135.48 105/13/1629.44 106/11/1424.73
RC 107/11/1230.48 108/10/1139.82
RC 201/4/1406.94 202/3/1365.65 203/3/1049.62 204/3/798.46 205/4/1297.65 206/3/1146.32
RC 207/3/1061.14 208/3/828.14
"""
HOMBERGER = """
R1_ 2_2/18/4039.86
C1_ 4_2/36/7686.38
RC1_ 6_5/55/16559.78
R2_ 8_6/15/20412.02
C2_ 10_3/28/16829.47
RC2_ 10_8/18/23595.33
"""
LI_LIM = """
LC 101/10/828.94 102/10/828.94 103/9/1035.35 104/9/860.01 105/10/828.94 106/10/828.94
LC 107/10/828.94 108/10/826.44 109/9/1000.60
LC 201/3/591.56 202/3/591.56 203/3/591.17 204/3/590.60 205/3/588.88 206/3/588.49
LC 207/3/588.29 208/3/588.32
LR 101/19/1650.80 102/17/1487.57 103/13/1292.68 104/9/1013.39 105/14/1377.11 106/12/1252.62
LR 107/10/1111.31 108/9/968.97 109/11/1208.96 110/10/1159.35 111/10/1108.90 112/9/1003.77
LR 201/4/1253.23 202/3/1197.67 203/3/949.40 204/2/849.05 205/3/1054.02 206/3/931.63
LR 207/2/903.06 208/2/734.85 209/3/930.59 210/3/964.22 211/2/911.52
LRC 101/14/1708.80 102/12/1558.07 103/11/1258.74 104/10/1128.40 105/13/1637.62 106/11/1424.73
LRC 107/11/1230.14 108/10/1147.43
LRC 201/4/1406.94 202/3/1374.27 203/3/1089.07 204/3/818.66 205/4/1302.20 206/3/1159.03
LRC 207/3/1062.05 208/3/852.76
"""
_KNOWN = {**_read(SOLOMON), **_read(HOMBERGER), **_read(LI_LIM)}
