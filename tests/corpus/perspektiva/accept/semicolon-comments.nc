%CORPUS
;both forms of comment
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200. ; down
X20. (across)
M30
%
