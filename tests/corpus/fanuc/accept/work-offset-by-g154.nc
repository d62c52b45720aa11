%
O0001
(G154 P1 of Haas is G54.1 P1; a P without its code's row is dropped by senders)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G154 P1
G0 X5. Y5. Z60.
G1 Z50. F200.
X90. Y40.
G154 P48
G0 X5. Y5. Z60.
G1 Z50.
X-90. Y40.
G54
G0 X20. Y20. Z60.
M30
%
