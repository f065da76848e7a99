"""Small random campaigns, made in a fraction of a second and diagnosed in seconds.

Layouts, places, parameters, errors and concealed effects are all drawn. Two makers compute the records: `elements`
by the challenge's own finite elements, and `model` by the tool's own prediction of an amended campaign.
"""
