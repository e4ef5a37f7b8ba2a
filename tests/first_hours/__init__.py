"""The first hour of six roles, each made of steps that README and guide show, in one state."""
