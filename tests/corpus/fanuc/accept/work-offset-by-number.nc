%
O0001
(G54 P1 is the numbered offset G54.1 P1, not G54 with a word to spare: G-code senders drop the P)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G54 P1
G0 X5. Y5. Z60.
G1 Z50. F200.
X90. Y40.
G54.1 P48
G0 X5. Y5. Z60.
G1 Z50.
X-90. Y40.
G54
G0 X20. Y20. Z50.
G1 X30.
G0 Z60.
M30
%
