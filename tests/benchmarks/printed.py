"""What the paper prints: Mehta, Taghipour and Saeedi (2022), arXiv:2203.01298; and one other."""

HARDWARE = "networks on one NVIDIA V100, everything else on a dual-core Intel i5"

# Hypervolume in per cent at 40, 200, 500 and 1000 cities. For 40 the reference point is (50, 50),
# whatever the text says: at (40, 40) no front reaches the figures.
HYPERVOLUME = {
    "NSGA-II (20K)": (67.3, 45.4, 38.4, 33.8),
    "NSGA-II (80K)": (72.5, 53.9, 46.36, 41.48),
    "MOEA/D (20K)": (66.7, 47.5, 40.4, 35.7),
    "MOEA/D (80K)": (70.7, 55.98, 48.8, 43.89),
    "DRL-MOA": (73.6, 80.63, 84.5, 85.9),
    "PA-EAN": (75.4, 83.2, 86.92, 88.45),
    "PA-AT": (74.18, 80.9, 85.15, 87.35),
    "OR-Tools (no limit)": (78.14, 86.5, 91.07, 93.39),
    "OR-Tools (n_l = 10)": (78.08, 84.8, 89.8, 92.38),
}
SECONDS = {
    "NSGA-II (20K)": (5.64, 8.04, 14.7, 27.1),
    "NSGA-II (80K)": (21.7, 30.8, 58.7, 107.3),
    "MOEA/D (20K)": (9.357, 12.7, 20.7, 33.5),
    "MOEA/D (80K)": (34.65, 48.2, 79.53, 130.75),
    "DRL-MOA": (5.87, 29.3, 72.9, 145.5),
    "PA-EAN": (1.59, 6.03, 15.14, 30.38),
    "PA-AT": (2.6, 13.4, 33.5, 68.2),
    "OR-Tools (no limit)": (2.16, 86.8, 732, 3730),
    "OR-Tools (n_l = 10)": (0.93, 10.4, 53.5, 209),
}

# Batch size, epochs, steps an epoch, cities, hours.
TRAINING = {
    "PA-EAN": ("60", "1", "20000", "120", "~12"),
    "PA-AT": ("60", "3", "5000", "40", "~8"),
    "PA-AD": ("60", "4", "5000", "40", "~10"),
    "DRL-MOA": ("200", "1 a network", "2500", "40", "~9"),
}

# The same at 40, 100 and 200 places on maps.
COVERAGE_HYPERVOLUME = {
    "PA-AD": (71.59, 72.14, 76.4),
    "OR-Tools (n_l = 100)": (75.9, 78.7, 84.29),
    "OR-Tools (n_l = 10)": (66.6, 68.5, 82.4),
}
COVERAGE_SECONDS = {
    "PA-AD": (3.06, 6.26, 11.85),
    "OR-Tools (n_l = 100)": (2.15, 17.4, 82.5),
    "OR-Tools (n_l = 10)": (0.75, 2.72, 9.9),
}

# The ablations, a minus for the layer left out: preferences at 40, 200, 500 and 1000 cities, the
# encoder of graphs at 40, 100 and 200 places.
PREFERENCE_LAYER = {
    "PA-EAN": (75.4, 83.2, 86.92, 88.4),
    "PA-EAN-": (39.1, 25.6, 25.0, 24.6),
    "PA-AT": (74.18, 80.9, 85.15, 87.3),
    "PA-AT-": (52.0, 48.9, 52.9, 55.8),
}
GRAPH_ENCODER = {"PA-AD": (71.59, 72.14, 76.4), "PA-AD-": (60.0, 53.0, 53.2)}

# Chen, Cao, Wang, Wu, Qin, Zhang and Gong (2025), Rethinking neural multi-objective combinatorial
# optimization via neat weight embedding: hypervolume in per cent of the box to these reference
# points, by number of cities, over 101 weights on 200 uniform instances.
LITERATURE_CORNERS = {20: 20, 50: 35, 100: 65, 150: 85, 200: 115}
LITERATURE = {
    "weight embedding with conditional attention, greedy": (62.70, 63.92, 70.34, 70.08, 73.46),
    "the same, 64 symmetries": (62.71, 64.13, 70.66, 70.44, 73.81),
    "weighted sums by LKH": (62.70, 64.15, 70.90, 71.49, 74.90),
}

# The same under three objectives; printed are hypervolumes over 105 weights, at 20, 50 and 100.
TRI_CORNERS = {20: 20, 50: 35, 100: 65}
TRI = {
    "the best single network, greedy": (47.07, 43.89, 49.76),
    "the best networks, with symmetries": (47.13, 44.32, 50.49),
    "weighted sums by LKH": (47.12, 44.40, 50.76),
}

# Rows of both, by name.
ON_PUBLIC_SETS = {
    "best networks, with symmetries": (
        "the same, 64 symmetries",
        "the best networks, with symmetries",
    ),
    "weighted sums by LKH": ("weighted sums by LKH", "weighted sums by LKH"),
}

# Fleets, by customers: hypervolumes of 200 instances, Bi-CVRP.
FLEET_METHODS = ("the best that is printed", "MOEA/D", "PPLS/D-C")
FLEETS = {
    20: (0.4305, 0.4255, 0.4287),
    50: (0.4106, 0.4000, 0.4007),
    100: (0.4090, 0.3953, 0.3946),
}
