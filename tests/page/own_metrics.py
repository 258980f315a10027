"""Metrics for the test of their curves on the page."""

METRICS = {"flown": "s", "height": "m"}


def flown(run):
    return run["t"][-1]


def height(run):
    return run["position"][-1, :, 2].max() if run["t"][-1] > 5 else None
