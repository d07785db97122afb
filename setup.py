"""The Python package of cloth_sim, for catkin_python_setup() in CMakeLists.txt; never run by hand."""
from setuptools import setup

from catkin_pkg.python_setup import generate_distutils_setup

setup(**generate_distutils_setup(
    packages=['cloth_sim', 'cloth_sim.tasks'],
    package_dir={'': 'python'},
    package_data={'cloth_sim': ['scenes/*.yaml']}))
