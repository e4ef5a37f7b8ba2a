"""Look for changes to a fleet without a plan after which it has one, by trying them."""
