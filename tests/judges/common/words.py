"""Numbers of words of NC programs."""


def number(value: float, digits: int = 3) -> str:
    """With as many decimals as it needs, `digits` at most, and a point always: without one a control may count
    increments."""
    whole, _, part = f"{value:.{digits}f}".partition(".")
    text = f"{whole}.{part.rstrip('0')}"
    return text if float(text) else "0."
