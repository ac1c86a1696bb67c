"""What Lotus Suspension Analysis (SHARK v4.03) printed for the built-in double wishbone, a right wheel.

From the report that voila-sus 0.2.0 ships with its tests (front_type1_report.txt); angles in degrees, printed
to 1e-4. Bump is the travel of the contact point along z: the lowest point of a thin disc of ROLLING_RADIUS
about the wheel centre, across the spin axis.
"""

ROLLING_RADIUS = 270.0  # mm

# bump, mm: camber (+ out at the top), toe (+ in), castor (+ rearward at the top), kingpin (+ in at the top)
BUMP = {
    -37.5: (1.4532, -0.3378, 4.4964, 5.566),
    -30.0: (1.1943, -0.2173, 4.584, 5.8165),
    -22.5: (0.9196, -0.1231, 4.6717, 6.0847),
    -15.0: (0.6291, -0.0554, 4.7595, 6.3706),
    -7.5: (0.3226, -0.0143, 4.8477, 6.6745),
    0.0: (0.0, 0.0, 4.936, 6.9968),
    7.5: (-0.3389, -0.0127, 5.0247, 7.3376),
    15.0: (-0.6942, -0.0526, 5.1137, 7.6975),
    22.5: (-1.0663, -0.1203, 5.2031, 8.0767),
    30.0: (-1.4554, -0.2161, 5.2929, 8.4758),
    37.5: (-1.8618, -0.3405, 5.3832, 8.8952),
}
