%CORPUS
(G83 with its first hole, then holes by X and Y alone)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G98 G83 X20. Y20. Z40. R52. Q3. F100.
X40.
Y40.
G99 X20.
G80
M30
%
