"""Fits hardpoints to measured curves, and finds which corrections the curves do not determine."""
