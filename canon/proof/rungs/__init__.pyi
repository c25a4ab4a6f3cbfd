from .ladder import prove_zero as prove_zero
