//! Forks are exact, and the judge finds what is planted.
