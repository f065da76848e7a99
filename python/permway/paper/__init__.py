"""The paper's system: its printed numbers, the conventions behind them, and their reproduction.

"Insights into Underrail Rubber Pad's Effect on Vehicle-Track-Viaduct System Dynamics", Shock and Vibration, 2021.
"""
