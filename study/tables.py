"""Reads the CSV tables of cloth_study."""
import csv
import os


def read(folder, name):
    """The rows of DIR/NAME as dictionaries; none if there is no such table."""
    path = os.path.join(folder, name)
    if not os.path.exists(path):
        return []
    with open(path, newline='') as file:
        return list(csv.DictReader(file))
