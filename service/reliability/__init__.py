"""Plan tours whose costs spread: by their mean, or by what nine days of ten do not exceed."""
