(executed and expanded)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
o100 sub
G1 X20. F200.
o100 endsub
o100 call
M2
