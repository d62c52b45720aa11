from typing import List, Optional, Tuple

from ._messages import Told

def correct(text: bytes, name: str, options: List[str], force: bool) -> Tuple[bytes, str, List[Told]]: ...
def check(
    original: Tuple[str, bytes], corrected: Tuple[str, bytes], options: List[str]
) -> Tuple[str, str, List[Told]]: ...
def predict(
    arrays: List[bytes], include_setup: bool, options: List[str]
) -> Tuple[bytes, bytes, List[bool], bytes, List[Told]]: ...
def solve(arrays: List[bytes], options: List[str]) -> Tuple[bytes, List[int], bytes, bytes]: ...
def diagnose(
    rows: Tuple[str, bytes],
    holdout: Optional[Tuple[str, bytes]],
    asked: Tuple[List[str], bool, int, List[str]],
    options: List[str],
) -> str: ...
def grid(
    nodes: str, tool: Optional[str], rotary: Optional[str], options: List[str]
) -> Tuple[List[List[float]], bytes, List[Told]]: ...
