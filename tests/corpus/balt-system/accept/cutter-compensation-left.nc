;G41: the contour is corrected, no block is split, G40 ends it; splitters broke the look-ahead here
G17 G71 G90
G0 X10 Y10 Z60
G1 Z50 F200
G41 X20 Y10
X24 Y14
X28 Y18
G1 X28 Y22
G40 X20 Y22
G0 Z60
M30
