"""A test programme for wheel slide protection in the style of EN 15595, and its scorecard.

`programme` says which stops there are, `scorecard` what is measured on each, `limits` what is marked; `runner` does the
stops on the cores, `report` and `figures` show them. Nothing in here quotes a standard: "EN 15595-style" means that the
programme follows the headings of one, and every limit carries its source.
"""
