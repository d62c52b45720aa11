(expect VP0222)
(corrected, the hole has a depth and an R of its own; the next hole inherits them only where this one is drilled)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G99 G83 X20. Y20. Z40. R52. Q3. F100.
X40.
/Y40.
X20.
G80
M30
