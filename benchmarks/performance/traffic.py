"""The case of a cluster: bytes and messages of each task, as `benchmarks/cluster.py` has them."""

import importlib.util


def prepare_traffic():
    """Return a function that measures what a task sends and receives."""
    import cluster

    return lambda: {"table": cluster.measure()}


HAS_CLUSTER = importlib.util.find_spec("cluster") is not None
CASES = {"cluster: traffic": prepare_traffic} if HAS_CLUSTER else {}
