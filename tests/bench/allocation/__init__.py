"""Allocators side by side: the same requests, the same DP loop, the same measures, rivals of other projects too."""
