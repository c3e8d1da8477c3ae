"""Regions: where is a method stable, what is known of it beside, and how do methods compare?"""
