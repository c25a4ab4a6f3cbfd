"""Service limits: how much of everything one client, and all of them together, can ask for."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Limits"]


@dataclass(frozen=True)
class Limits:
    """What a service does at most.

    Parameters
    ----------
    workers
        Processes that judge at the same time.
    budget
        Seconds for each claim, whatever it says itself.
    body
        Bytes of one request.
    claims
        Claims of one request.
    waiting
        Claims of all clients that are judged or wait for it.
    rate
        Claims a minute for each client; forty texts read count as one, a second of judging or reading as one more.
    burst
        Claims that a client who has not asked for a while may ask at once.
    connections
        Connections that are open at the same time.
    drain
        Seconds for which a stopping service waits for the answers in hand.

    Raises
    ------
    ValueError
        Where a limit is not positive, or where one request could be more than all may wait.

    Examples
    --------
    >>> Limits(workers=4, budget=2.0).claims
    100
    """

    workers: int = 2
    budget: float = 5.0
    body: int = 262_144
    claims: int = 100
    waiting: int = 200
    rate: float = 60.0
    burst: float = 60.0
    connections: int = 256
    drain: float = 30.0

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not 0 < value < 1e9:
                raise ValueError(f"{name} should be a positive number, not {value!r}")
        if self.budget > 3600:
            raise ValueError(f"budget should be a number of seconds up to 3600, not {self.budget!r}")
        if self.waiting < self.claims:
            raise ValueError(
                f"a request may have {self.claims} claims and only {self.waiting} may wait: raise waiting"
            )
