; expect VP0105: a comment only first on its line
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60. : REMARK
M30
