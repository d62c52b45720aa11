%CORPUS
(G41: the contour is corrected, no block is split, G40 ends it; splitters broke the look-ahead here)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G41 D1 X20. Y10.
X24. Y14.
G3 X28. Y18. R4.
G1 X28. Y22.
G40 X20. Y22.
G0 Z60.
M30
%
