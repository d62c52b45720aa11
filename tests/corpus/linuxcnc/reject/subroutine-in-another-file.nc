(expect VP0127)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
o<pocket> call [1] [2]
M2
