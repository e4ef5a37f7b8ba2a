"""Say and read times, durations and lengths as people do: "10:00", "2:10 h", "14.2 km", "3%"."""
