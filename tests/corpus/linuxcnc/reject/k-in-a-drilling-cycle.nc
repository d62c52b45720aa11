%
(expect VP0217: K counts nothing on this control)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G91 G81 X2. Y0. Z-5. R-2. F200. K3
M2
%
