"""Baumgarte's gains on a plane: where bonds hold in runs, and where theory says so. Draws gains.png."""

import taut

found = taut.stability("freely_jointed", ["baumgarte", "feedforward", "rattle"], quick=True, draw=True)
taut.pictures.save(found["figures"]["plane"], "gains")
calibrated = taut.calibrate("freely_jointed", sweeps=4)
print(f"four sweeps of RATTLE reduce an error by {calibrated['reduction_rattle']:.3f} a step; Baumgarte does with "
      f"alpha = {calibrated['alpha_per_ps']:.3g}, beta = {calibrated['beta_per_ps']:.3g} per ps")
