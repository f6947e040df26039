/* The end of the chain. */
float chain_third(float x)
{
    return x * 33.0;
}
