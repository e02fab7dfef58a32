"""The tour: five steps on the sample bones that the user does."""
