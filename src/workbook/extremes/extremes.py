"""Makes extremes.csv: u, -ln(1 - u) and 1 - exp(-u), and the nearest u that is a whole number of 2^-53 with -ln(1 - u)
there. Function values are sums of two doubles, computed with mpmath (pip install mpmath).

python3 src/workbook/extremes/extremes.py > src/workbook/extremes/extremes.csv
"""
import random
from mpmath import exp, log, mp, mpf

mp.prec = 300
random.seed(1)


def twofold(x):
    high = float(x)
    return f"{high!r},{float(x - mpf(high))!r}"


print("u,log_high,log_low,cdf_high,cdf_low,grid,grid_log_high,grid_log_low")
for i in range(240):
    # evenly spaced on a logarithmic axis from 1e-18 to 1, with random last digits
    u = 10 ** (-18 + 18 * (i + random.random()) / 240)
    exact = mpf(u)
    grid = max(round(u * 2.0**53), 1) / 2.0**53
    on_grid = twofold(-log(1 - mpf(grid)))
    print(f"{u!r},{twofold(-log(1 - exact))},{twofold(1 - exp(-exact))},{grid!r},{on_grid}")
