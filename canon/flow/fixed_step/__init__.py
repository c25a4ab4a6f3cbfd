"""Methods of fixed step run by compiled loops: samples, statistics and events along them."""
