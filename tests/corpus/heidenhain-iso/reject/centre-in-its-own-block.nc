%CENTRE G71 *
N10 ;expect VP0225: the centre would hold for all arcs behind it *
N20 G00 G40 G90 X+45 Y+25 Z+50 *
N30 G01 Z+0 F200 *
N40 I+25 J+25 *
N50 G02 X+25 Y+45 *
N60 M30 *
N99999999 %CENTRE G71 *
