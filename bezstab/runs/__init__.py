"""Whether the prediction holds: measured poles, predicted errors, what accuracy costs.

The only room in which stability and mechanism meet.
"""
