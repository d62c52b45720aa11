(expect VP0217: from where each block starts, or held?)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G99 G81 X5. Z40. R52. F100.
G91 X5.
G90 G80
M30
