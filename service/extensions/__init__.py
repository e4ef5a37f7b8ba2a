"""Use functions of other packages to build tours and to search, where the operator names them."""
