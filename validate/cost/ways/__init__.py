"""The methods of the study, one file for each family."""
