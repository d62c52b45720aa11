G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
o100 sub
G1 X#1 Y[#2/2] F200.
o100 endsub [#1+1]
o100 call [20] [30]
G1 X#<_value>
M2
