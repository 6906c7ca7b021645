"""A sweep as a pandas table: how far the caterpillar comes with each amplitude and frequency, and at what cost.

Packages: python3-pandas.
"""

import itertools

import pandas
import proleg

scenario = proleg.Scenario("caterpillar", engine="reduced")
grid = list(itertools.product([20, 30, 40, 50], [0.5, 1.0, 1.5]))
table = pandas.DataFrame(grid, columns=["amplitude", "frequency"])
table[["distance", "cost_of_transport"]] = proleg.evaluate(scenario, list(table.columns), grid, ["distance", "cost_of_transport"])
print(table.pivot(index="amplitude", columns="frequency", values="distance").round(2))
