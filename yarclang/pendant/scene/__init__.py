"""The robot in three dimensions: conversion of the viewer's stage to messages and binary meshes for
browsers.
"""
