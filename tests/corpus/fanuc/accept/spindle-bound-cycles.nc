%
O0001
(G74, G84.2, G84.3, G88: the feed and the spindle belong together, so they stay cycles hole by hole; expanders wrote G1 for a tap)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
M4 S500
G98 G74 X20. Y20. Z40. R52. F500.
X40.
G80
M3 S500
G84.2 X20. Y40. Z40. R52. F500.
X40.
G80
M4 S500
G84.3 X20. Y60. Z40. R52. F500.
X40.
G80
M3 S500
G88 X20. Y80. Z40. R52. P500 F100.
X40.
G80
G0 Z60.
M30
%
