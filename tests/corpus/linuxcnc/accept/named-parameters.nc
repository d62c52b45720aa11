G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
#<depth of cut>=55
#<_feed rate>=150
G1 Z#<depthofcut> F#<_feedrate>
M2
