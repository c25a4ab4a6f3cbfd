from .budget import prove_in_worker as prove_in_worker
