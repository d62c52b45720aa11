G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
o<halve> sub
G1 X[10+#1] F200.
o<stop> if [#1 GT 4]
o<halve> call [#1/2]
o<stop> endif
o<halve> endsub
o<halve> call [32]
M2
