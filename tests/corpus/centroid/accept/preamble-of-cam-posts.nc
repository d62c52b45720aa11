; what CAM posts write for Centroid: G53 G00 G17 without an axis, comments behind ;, M25 for Z home
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G53 G00 G17
G21
; begin operation (X99. is no word)
M6 T1
M3 S6000
G0 X10. Y10. Z60.
G1 Z50. F200. ; plunge
G2 X20. Y20. I5. J5. F600.
M5 M25
G0 X10. Y10. Z60.
M99
