"""Is this expression zero on this domain?"""
