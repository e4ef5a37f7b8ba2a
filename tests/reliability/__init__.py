"""Tests of service.reliability."""
