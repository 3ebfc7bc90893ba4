"""The robot and its surroundings in three dimensions: conversion of a stage (all that the 3D viewer draws)
to messages and binary meshes for browsers.
"""
